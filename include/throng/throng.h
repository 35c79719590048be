// Everything of throng's public API.
#pragma once

#include <throng/character.h>
#include <throng/controller.h>
#include <throng/crowd.h>
#include <throng/device.h>
#include <throng/draw.h>
#include <throng/index.h>
#include <throng/joint_sampler.h>
#include <throng/procedural.h>
#include <throng/reference.h>
#include <throng/version.h>
