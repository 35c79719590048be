#include "import/draco.h"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

namespace throng::gltf {
namespace {

// libdraco allocates the sizes that the stream claims. These decoders read the claims at the two places where all of
// them are known, and charge them before libdraco goes on: to `of_mesh` what the mesh keeps, to `working` what is freed
// with the decoder. Failures are stored, not thrown through libdraco.
template <class Base>
class Guarded final : public Base {
public:
    Guarded(TemporaryCharge& of_mesh, TemporaryCharge& working, std::string place)
        : of_mesh_(of_mesh), working_(working), place_(std::move(place)) {}

    std::optional<Failure> failure;

protected:
    bool DecodeConnectivity() override {
        draco::DecoderBuffer ahead = *this->buffer();
        uint32_t face_count = 0, vertex_count = 0;
        uint8_t seam_count = 0;  // attributes with a corner table of their own
        bool read = false;
        if constexpr (std::is_base_of_v<draco::MeshEdgebreakerDecoder, Base>)
            read = draco::DecodeVarint(&vertex_count, &ahead) && draco::DecodeVarint(&face_count, &ahead) &&
                   ahead.Decode(&seam_count);
        else
            read = draco::DecodeVarint(&face_count, &ahead) && draco::DecodeVarint(&vertex_count, &ahead);
        // A corner table has two 32-bit numbers for each of a face's three corners. Building it takes as much again,
        // the faces of the mesh included.
        return read && charge(of_mesh_, face_count, 12) &&
               charge(working_, face_count, 36 + 48 * uint64_t(seam_count)) && charge(working_, vertex_count, 32) &&
               Base::DecodeConnectivity();
    }

    bool DecodeAllAttributes() override {
        const draco::PointCloud& points = *this->point_cloud();
        for (int i = 0; i < points.num_attributes(); ++i) {
            const draco::PointAttribute& attribute = *points.attribute(i);
            const uint64_t component_bytes = uint64_t(draco::DataTypeLength(attribute.data_type()));
            const uint64_t component_count = uint64_t(attribute.num_components());
            // The values as stored and the map from points to values; while decoding, also the values as 32-bit
            // integers, and what their prediction takes.
            if (!charge(of_mesh_, points.num_points(), component_count * component_bytes + 4) ||
                !charge(working_, points.num_points(), component_count * 8))
                return false;
        }
        return Base::DecodeAllAttributes();
    }

private:
    bool charge(TemporaryCharge& to, uint64_t count, uint64_t element_bytes) {
        try {
            to.add(count, element_bytes, place_);
            return true;
        } catch (const Failure& f) {
            failure = f;
            return false;
        }
    }

    TemporaryCharge& of_mesh_;
    TemporaryCharge& working_;
    std::string place_;
};

template <class Base>
void decode(const JsonView& json, draco::DecoderBuffer& buffer, Budget& budget, TemporaryCharge& of_mesh,
            draco::Mesh& mesh) {
    TemporaryCharge working(budget);
    Guarded<Base> decoder(of_mesh, working, json.place());
    const draco::DecoderOptions options;
    const draco::Status status = decoder.Decode(options, &buffer, &mesh);
    if (decoder.failure) throw *decoder.failure;
    if (!status.ok()) throw std::runtime_error(status.error_msg_string());
}

template <class T>
bool convert(const draco::PointAttribute& attribute, uint32_t vertex_count, uint32_t component_count,
             std::vector<std::byte>& out) {
    T value[16] = {};
    for (uint32_t v = 0; v < vertex_count; ++v) {
        if (!attribute.ConvertValue<T>(attribute.mapped_index(draco::PointIndex(v)), int8_t(component_count), value))
            return false;
        std::memcpy(out.data() + size_t(v) * component_count * sizeof(T), value, component_count * sizeof(T));
    }
    return true;
}

}  // namespace

DracoMesh::DracoMesh(const JsonView& json, Buffers& buffers, Budget& budget)
    : json_(json), budget_(budget), charge_(budget), mesh_(std::make_unique<draco::Mesh>()) {
    const auto bytes = buffers.view_of(json).bytes;
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::DracoHeader header;
    draco::DecoderBuffer ahead = buffer;
    if (!draco::PointCloudDecoder::DecodeHeader(&ahead, &header).ok() || header.encoder_type != draco::TRIANGULAR_MESH)
        json.fail("the compressed data are not a Draco mesh");
    if (header.version_major != 2 || header.version_minor != 2)
        throw Failure(ErrorCode::kUnsupported, json.place(), "Draco bitstream ", header.version_major, ".",
                      header.version_minor, " is not supported, only 2.2");
    try {
        if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
            decode<draco::MeshEdgebreakerDecoder>(json, buffer, budget, charge_, *mesh_);
        else if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
            decode<draco::MeshSequentialDecoder>(json, buffer, budget, charge_, *mesh_);
        else
            json.fail("the compression method is unknown");
    } catch (const Failure&) {
        throw;
    } catch (const std::exception& error) {
        // Broken data can make libdraco request sizes that the standard library refuses by an exception.
        json.fail("the compressed data are broken (libdraco: ", printable(error.what(), 100), ")");
    }
}

DracoMesh::~DracoMesh() = default;

std::optional<AccessorView> DracoMesh::attribute(std::string_view name, const AccessorFormat& format) const {
    const JsonView ids = json_.required_object("attributes");
    const auto id = ids.find(name);
    if (!id) return {};
    const draco::PointAttribute* attribute = mesh_->GetAttributeByUniqueId(
        uint32_t(std::min<uint64_t>(id->as_uint(), kNone)));
    if (!attribute) id->fail("the compressed data have no attribute with this id");
    if (attribute->num_components() != format.component_count)
        id->fail("has ", attribute->num_components(), " components, but its accessor is ", format.type);
    if (mesh_->num_points() != format.count)
        id->fail("has ", mesh_->num_points(), " vertices, but accessors[", format.index, "] has ", format.count);
    if (attribute->size() == 0 && format.count > 0) id->fail("has no values");

    const auto values = charged_bytes(budget_, format.count, format.element_bytes(), id->place());
    const bool converted = visit_component(format.component_type, [&](auto zero) {
        return convert<decltype(zero)>(*attribute, format.count, format.component_count, *values);
    });
    if (!converted) id->fail("its values are not ", format.component_text());
    return AccessorView{format, values->data(), format.element_bytes(), values};
}

std::vector<uint32_t> DracoMesh::indices() const {
    budget_.charge(mesh_->num_faces(), 3 * sizeof(uint32_t), json_.place());
    std::vector<uint32_t> out;
    out.reserve(size_t(mesh_->num_faces()) * 3);
    for (draco::FaceIndex f(0); f < mesh_->num_faces(); ++f)
        for (const draco::PointIndex& corner : mesh_->face(f)) out.push_back(corner.value());
    return out;
}

}  // namespace throng::gltf
