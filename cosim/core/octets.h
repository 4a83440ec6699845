#pragma once
// The octets of a radio frame or a packet in a message, which must stay as cheap to copy as a number.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::cosim {

/// An immutable string of octets: copying it copies a pointer. What was ever made stays until the process
/// ends, but not in memory: all but the newest few MB are moved into a file without a name in /var/tmp (or
/// TMPDIR), from where the kernel reads what is looked at again. Where no file can be made they stay in
/// memory. Any thread may make one.
class Octets {
  public:
    Octets() = default;  ///< none
    /// At most kMostOctets of them.
    explicit Octets(std::span<const std::uint8_t> octets);

    std::span<const std::uint8_t> view() const {
        return kept_ == nullptr ? std::span<const std::uint8_t>{} : std::span(first(), kept_->size);
    }
    std::size_t size() const { return kept_ == nullptr ? 0 : kept_->size; }

    /// By content.
    friend bool operator==(const Octets& a, const Octets& b);

  private:
    struct Kept {
        std::uint32_t size;  ///< of the octets behind it
    };
    const std::uint8_t* first() const { return reinterpret_cast<const std::uint8_t*>(kept_ + 1); }

    const Kept* kept_ = nullptr;  ///< null if there are none
};

inline constexpr std::size_t kMostOctets = 65'536;

}  // namespace puckloop::cosim
