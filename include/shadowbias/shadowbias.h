/* libshadowbias: correct, fast shadows on a CPU. Includes every public header. */
#ifndef SHADOWBIAS_SHADOWBIAS_H
#define SHADOWBIAS_SHADOWBIAS_H

#include "shadowbias/area.h"
#include "shadowbias/base.h"
#include "shadowbias/bias.h"
#include "shadowbias/clusters.h"
#include "shadowbias/context.h"
#include "shadowbias/filter.h"
#include "shadowbias/image.h"
#include "shadowbias/map.h"
#include "shadowbias/math.h"
#include "shadowbias/raster.h"
#include "shadowbias/reference.h"
#include "shadowbias/scene.h"
#include "shadowbias/shade.h"
#include "shadowbias/view.h"

#endif
