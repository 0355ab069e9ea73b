#include "patchlight/output/write_vtk.h"
