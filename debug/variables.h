#pragma once
// Where an image's variables lie in data space, by its symbols: what a stack must not grow into.

#include "emu/image/image.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace puckloop::debug {

class Variables {
  public:
    Variables() = default;
    /// `sizes`: bytes by symbol, where the image states them (image::symbol_sizes()); others count as one
    /// byte. The linker's own end of the variables (_end, __bss_end and the like of avr-gcc) counts where the
    /// stack comes from above. Symbols outside RAM are left out.
    Variables(const std::map<std::string, image::Symbol>& symbols,
              const std::map<std::string, std::uint32_t>& sizes, std::uint32_t ram_start,
              std::uint32_t ram_end, bool stack_from_above);

    /// Behind the last one; 0: the image names none.
    std::uint32_t end() const { return end_; }
    struct Overlap {
        std::uint32_t bytes = 0;
        std::vector<std::string> names;  ///< by address
    };
    /// With the data addresses first..behind-1.
    Overlap overlap(std::uint32_t first, std::uint32_t behind) const;
    /// "levels", "levels+2" for the byte behind its second, or empty: no variable lies there. Of several the
    /// one that begins last.
    std::string name_at(std::uint32_t address) const;

  private:
    struct Range {
        std::uint32_t first = 0, behind = 0;
        std::string name;  ///< empty: of the linker
    };
    std::vector<Range> ranges_;  ///< by address
    std::uint32_t end_ = 0;
};

}  // namespace puckloop::debug
