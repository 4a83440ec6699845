#pragma once
// The struct of an ioctl as bytes: read from and written to `data`, which may be shorter or longer.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>

namespace puckloop::linuxboard {

template <typename T>
T get_struct(const std::string& data, std::size_t place = 0) {
    T object;
    std::memset(static_cast<void*>(&object), 0, sizeof object);
    if (place < data.size())
        std::memcpy(static_cast<void*>(&object), data.data() + place,
                    std::min(sizeof object, data.size() - place));
    return object;
}

template <typename T>
void put_struct(std::string& data, const T& object, std::size_t place = 0) {
    if (place < data.size())
        std::memcpy(data.data() + place, &object, std::min(sizeof object, data.size() - place));
}

}  // namespace puckloop::linuxboard
