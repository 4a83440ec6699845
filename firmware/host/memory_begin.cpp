// First of all that is linked: the firmware's variables lie behind these.
#include "firmware/host/memory.h"
namespace hosted {
unsigned char data_begin[kMargin] = {1};
unsigned char bss_begin[kMargin];
}  // namespace hosted
