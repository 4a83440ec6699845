#include "base/random.h"

#include <bit>
#include <cmath>

namespace puckloop {

namespace {

std::uint64_t splitmix64(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/// FNV-1a, 64 bit.
std::uint64_t hash_name(std::string_view name) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (char c : name)
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return hash;
}

inline std::uint64_t draw(std::array<std::uint64_t, 4>& state) {
    const std::uint64_t result = std::rotl(state[1] * 5, 7) * 9;
    const std::uint64_t t = state[1] << 17;
    state[2] ^= state[0];
    state[3] ^= state[1];
    state[1] ^= state[2];
    state[0] ^= state[3];
    state[2] ^= t;
    state[3] = std::rotl(state[3], 45);
    return result;
}

inline double fraction(std::uint64_t bits) {
    return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view name) {
    std::uint64_t mix = seed;
    mix = splitmix64(mix) ^ hash_name(name);
    for (auto& word : state_)
        word = splitmix64(mix);
}

std::uint64_t RandomStream::next() {
    return draw(state_);
}

double RandomStream::uniform() {
    return fraction(draw(state_));
}

double RandomStream::normal() {
    if (has_spare_) {
        has_spare_ = false;
        return spare_;
    }
    double u = 0, v = 0, s = 0;
    std::array<std::uint64_t, 4> state = state_;
    do {
        u = 2.0 * fraction(draw(state)) - 1.0;
        v = 2.0 * fraction(draw(state)) - 1.0;
        s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    state_ = state;
    const double factor = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = v * factor;
    has_spare_ = true;
    return u * factor;
}

std::uint64_t RandomStream::below(std::uint64_t n) {
    const std::uint64_t limit = (~std::uint64_t{0} / n) * n;
    std::uint64_t draw = next();
    while (draw >= limit)
        draw = next();
    return draw % n;
}

}  // namespace puckloop
