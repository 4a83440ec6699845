#include "firmware/host/memory.h"

#include <cstddef>
#include <vector>

namespace hosted {

namespace {

/// Sanitizers must not look: between variables lies what nobody may touch.
void copy(unsigned char* to, const unsigned char* from, std::size_t bytes) {
    asm volatile("rep movsb" : "+D"(to), "+S"(from), "+c"(bytes) : : "memory");
}

struct Part {
    unsigned char* begin;
    std::size_t bytes;
    std::vector<unsigned char> first;

    Part(unsigned char* from, unsigned char* to)
        : begin(from + kMargin), bytes(static_cast<std::size_t>(to - begin)), first(bytes) {
        copy(first.data(), begin, bytes);
    }
    void restore() { copy(begin, first.data(), bytes); }
};

}  // namespace

void restore_memory() {
    static Part data(data_begin, data_end), bss(bss_begin, bss_end);
    data.restore();
    bss.restore();
}

}  // namespace hosted
