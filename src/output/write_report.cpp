#include "patchlight/output/write_report.h"
