#pragma once
// The octets of a radio frame or a packet in a message, which must stay as cheap to copy as a number.

#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::cosim {

/// An immutable string of octets, kept once a process for each content: copying it copies a pointer, equal
/// contents are the same pointer. What was ever made stays until the process ends, at most what the media
/// carry (31 KB a second of one busy radio channel at 250 kbit/s, on a network what programs send). Any
/// thread may make one.
class Octets {
  public:
    Octets() = default;  ///< none
    explicit Octets(std::span<const std::uint8_t> octets);

    std::span<const std::uint8_t> view() const {
        return kept_ == nullptr ? std::span<const std::uint8_t>{} : std::span(*kept_);
    }
    std::size_t size() const { return view().size(); }

    friend bool operator==(const Octets&, const Octets&) = default;

  private:
    const std::vector<std::uint8_t>* kept_ = nullptr;  ///< null if there are none
};

}  // namespace puckloop::cosim
