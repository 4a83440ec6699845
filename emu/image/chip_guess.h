#pragma once
// For which of the known chips an image was built, where nobody says so: by what ELF and COFF note, else by
// the addresses that it uses.

#include <string>
#include <vector>

namespace puckloop::image {

/// As --mcu takes them: "dspic30f6014a", "dspic33fj256gp710", "atmega1284p". Several where the image fits
/// several, none where it fits none. Throws InputError for a file that is no image.
std::vector<std::string> chips_that_fit(const std::string& path);

/// The file begins as firmware does: Intel HEX, ELF or COFF. False for a file that cannot be read.
bool looks_like_image(const std::string& path);

}  // namespace puckloop::image
