// Included before every line of the dsPIC firmware's C sources when they are compiled for the host, as C++: the
// target's integers in place of types.h, registers of the emulated chip in place of those of registers.h, which is
// read for its names, addresses and bits. HOSTED_DEFINE_REGISTERS: the one translation unit that defines them.

#include "firmware/host/register_objects.h"

namespace hosted {
void idle();
void no_interrupts(unsigned cycles);   ///< DISI
void assembly(const char* text);       ///< what cannot be said in C
}  // namespace hosted

#define EPUCK_TYPES_H
#define RAB_TYPES_H
using u8 = hosted::Int<unsigned char>;
using u16 = hosted::Int<unsigned short>;
using u32 = hosted::Int<unsigned int>;
using s16 = hosted::Int<short>;
using s32 = hosted::Int<int>;

#define __attribute__(list) HOSTED_ADDRESS list
#define sfr(address) address
#ifdef HOSTED_DEFINE_REGISTERS
#define HOSTED_ADDRESS(address, near) {hosted::Register<unsigned short>(address)}
#else
#define HOSTED_ADDRESS(address, near)
#endif
#define u16 hosted::Register<unsigned short>
#include "registers.h"
#undef u16
#undef HOSTED_ADDRESS
#undef sfr
#undef __attribute__

#undef INTERRUPT
#define INTERRUPT
#undef IDLE
#define IDLE() hosted::idle()
#undef DISI
#define DISI(cycles) hosted::no_interrupts(cycles)
#define __builtin_disi(cycles) hosted::no_interrupts(cycles)
#define __builtin_divud(a, b) hosted::divide_32_by_16(a, b)
/* Also read only for what that does to the peripheral. */
#define I2C1RCV hosted::discardable(I2C1RCV)
#define SPI1BUF hosted::discardable(SPI1BUF)
#define switch(x) switch (hosted::switched(x))
#define main firmware_main
/* __asm__ volatile("...") */
#define __asm__
#define volatile(...) hosted::assembly(#__VA_ARGS__)
