#pragma once
// Programs of the project's assemblers as ELF files with symbols, the least that makes a report name places.

#include <cstdint>
#include <map>
#include <string>

namespace puckloop::tests {

using Labels = std::map<std::string, std::uint32_t>;  ///< functions by name
struct Variable {
    std::uint32_t address = 0, bytes = 1;  ///< in data space
};
using VariablesByName = std::map<std::string, Variable>;

/// Program words by program address.
std::string dspic_elf(const std::map<std::uint32_t, std::uint32_t>& words, const Labels& labels,
                      const VariablesByName& variables = {});
/// Program bytes by byte address.
std::string avr_elf(const std::map<std::uint32_t, std::uint8_t>& bytes, const Labels& labels,
                    const VariablesByName& variables = {});

/// A file that is there as long as this is.
class ImageFile {
  public:
    ImageFile(const std::string& name, const std::string& content);
    ~ImageFile();
    ImageFile(const ImageFile&) = delete;
    ImageFile& operator=(const ImageFile&) = delete;
    const std::string path;
};

}  // namespace puckloop::tests
