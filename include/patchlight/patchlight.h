#pragma once

/// \file
/// The whole library: simulate() takes a Scene and a Request and returns a Simulation.

#include "patchlight/accuracy/error_bars.h"
#include "patchlight/base/diagnostics.h"
#include "patchlight/base/error.h"
#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/base/large_array.h"
#include "patchlight/base/progress.h"
#include "patchlight/form_factors.h"
#include "patchlight/gather/gather.h"
#include "patchlight/gather/readings.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/light/material.h"
#include "patchlight/light/spectrum.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/output/write_result.h"
#include "patchlight/plan/effects.h"
#include "patchlight/plan/plan.h"
#include "patchlight/render/image.h"
#include "patchlight/report/report.h"
#include "patchlight/scene/daylight.h"
#include "patchlight/scene/luminaire.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sensor.h"
#include "patchlight/scene/sides.h"
#include "patchlight/simulate.h"
#include "patchlight/solve/problem.h"
#include "patchlight/solve/solve.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/exchange.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/lost_share.h"
#include "patchlight/transport/sampling_error.h"
#include "patchlight/transport/transport_operator.h"
#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

/// How diffuse surfaces light each other: scenes, form factors, solvers, error bars and views of a solution.
namespace patchlight {}
