#include "patchlight/output/provenance.h"

namespace patchlight {

const char* version() { return PATCHLIGHT_VERSION; }

}  // namespace patchlight
