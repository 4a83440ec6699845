#pragma once
// The bytes a file asks to be programmed, by byte address: what every loader reads first. AVR images are used
// in this form; the dsPIC view (dspic_view.h) folds four bytes into a program word.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::image {

/// Contiguous bytes from one byte address on.
struct ByteSegment {
    std::uint64_t address = 0;
    std::vector<std::uint8_t> bytes;

    std::uint64_t end() const { return address + bytes.size(); }
};

/// Collects pieces in file order, then yields them sorted and joined.
class ByteSegments {
  public:
    /// `file` is the name for messages and must outlive this object.
    explicit ByteSegments(std::string_view file) : file_(file) {}
    /// `place` states where in the file the piece stands ("line 7"), for messages about overlaps. Throws
    /// InputError once the pieces exceed 8 MB, eight times the largest dsPIC: no damaged table may claim the
    /// machine's memory.
    void add(std::uint64_t address, std::vector<std::uint8_t> bytes, std::string place);
    /// Sorted by address, neighbours joined. Throws InputError naming both places when two pieces overlap.
    std::vector<ByteSegment> joined() const;

  private:
    struct Piece {
        ByteSegment segment;
        std::string place;
    };
    std::string_view file_;
    std::size_t total_ = 0;
    std::vector<Piece> pieces_;
};

}  // namespace puckloop::image
