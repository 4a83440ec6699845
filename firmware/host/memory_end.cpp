// Behind the firmware's objects.
#include "firmware/host/memory.h"
namespace hosted {
unsigned char data_end[kMargin] = {1};
unsigned char bss_end[kMargin];
}  // namespace hosted
