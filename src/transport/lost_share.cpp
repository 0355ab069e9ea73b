#include "patchlight/transport/lost_share.h"
