#pragma once
// Whether a firmware makes the main board an I2C slave, as far as its image shows.

#include <string>

namespace puckloop::pic {

/// An instruction of the image names I2CADD as what it writes: `mov`, `mov.b` or `bset`. Compilers reach
/// special function registers in no other way; a program that writes through a pointer is not recognised. A
/// word of a table may be taken for such an instruction. False for a file that is no image.
bool sets_slave_address(const std::string& file);

}  // namespace puckloop::pic
