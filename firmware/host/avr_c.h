// The same as dspic_c.h for the AVR firmware.

#include "firmware/host/register_objects.h"

namespace hosted {
void idle();              ///< SLEEP
void enable(bool on);     ///< SEI, CLI
void feed_watchdog();     ///< WDR
}  // namespace hosted

#define TYPES_H
using u8 = hosted::Int<unsigned char>;
using s8 = hosted::Int<signed char>;
using u16 = hosted::Int<unsigned short>;
using u32 = hosted::Int<unsigned int>;
using s16 = hosted::Int<short>;

#include "registers.h"

#undef REGISTER8
#undef REGISTER16
#define REGISTER8(address) hosted::Register<unsigned char>(hosted::Int<unsigned short>(address).read())
#define REGISTER16(address) hosted::Register<unsigned short>(hosted::Int<unsigned short>(address).read())
#undef SEI
#undef CLI
#undef SLEEP
#undef WDR
#define SEI() hosted::enable(true)
#define CLI() hosted::enable(false)
#define SLEEP() hosted::idle()
#define WDR() hosted::feed_watchdog()
#undef INTERRUPT
#define INTERRUPT(name) void name(void)
#define switch(x) switch (hosted::switched(x))
#define main firmware_main
