#include "base/json.h"

PUCKLOOP_JSON()
