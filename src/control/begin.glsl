// Resets an instance with a controller. The includer declares the buffers `layers`, `parameters` and `inertias`, and
// `initial_layers` and `initial_parameters`, the values to reset to.

void begin_controller(uint instance, uint layer_count, uint parameter_count, bool is_inertial) {
    for (uint i = 0; i < layer_count; ++i) layers[instance * layer_count + i] = initial_layers[i];
    for (uint i = 0; i < parameter_count; ++i) parameters[instance * parameter_count + i] = initial_parameters[i];
    if (is_inertial) inertias[instance] = InstanceInertia(0, 0, 0, 0, 0, 0);
}
