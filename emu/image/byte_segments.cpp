#include "emu/image/byte_segments.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace puckloop::image {

namespace {
constexpr std::size_t kLargestTotal = 8u << 20;
}

void ByteSegments::add(std::uint64_t address, std::vector<std::uint8_t> bytes, std::string place) {
    total_ += bytes.size();
    if (total_ > kLargestTotal)
        throw InputError(file_, place, "more than 8 MB of program data", "what a microcontroller can hold");
    if (!bytes.empty()) pieces_.push_back({{address, std::move(bytes)}, std::move(place)});
}

std::vector<ByteSegment> ByteSegments::joined() const {
    std::vector<const Piece*> order;
    for (const Piece& piece : pieces_)
        order.push_back(&piece);
    std::stable_sort(order.begin(), order.end(), [](const Piece* left, const Piece* right) {
        return left->segment.address < right->segment.address;
    });
    std::vector<ByteSegment> result;
    const Piece* previous = nullptr;
    for (const Piece* piece : order) {
        if (previous && piece->segment.address < result.back().end())
            throw InputError(file_, piece->place,
                             fmt::format("data at byte address 0x{:X} was already given by {}",
                                         piece->segment.address, previous->place),
                             "each address once");
        if (result.empty() || piece->segment.address != result.back().end())
            result.push_back(piece->segment);
        else
            result.back().bytes.insert(result.back().bytes.end(), piece->segment.bytes.begin(),
                                       piece->segment.bytes.end());
        previous = piece;
    }
    return result;
}

}  // namespace puckloop::image
