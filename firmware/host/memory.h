#pragma once
// The firmware's variables, so that each input finds them as at power-up. They lie between two objects'
// because the linker keeps the order of the objects within a section.

namespace hosted {

inline constexpr int kMargin = 64;
extern unsigned char data_begin[kMargin], data_end[kMargin], bss_begin[kMargin], bss_end[kMargin];

/// Of the firmware's variables; the first call keeps what they begin with.
void restore_memory();

}  // namespace hosted
