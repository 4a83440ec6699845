#pragma once
// What the main board's camera looks at. Whoever knows the world implements it; the camera knows only this.

#include <cstdint>
#include <map>
#include <span>

namespace puckloop::camera {

class Scenery {
  public:
    virtual ~Scenery() = default;

    /// The whole field of view in `width` x `height` pixels, as seen now: rows from the top, red, green, blue
    /// of each pixel. `frame` counts the pictures of this camera, for the sensor's noise.
    virtual void render(std::uint32_t width, std::uint32_t height, std::uint64_t frame,
                        std::span<std::uint8_t> rgb) = 0;

    // A scenery that changes with time. One that stands still need not care.
    /// Value `value` of signal `id` at the board's port `camera`.
    virtual void change(std::uint16_t /*id*/, double /*value*/) {}
    /// Goes back to the last mark(), until settle(), as cosim::Rewindable.
    virtual void mark() {}
    virtual void rewind() {}
    virtual void settle() {}
    /// The last value of each signal that came in, for a saved state; restore() takes them up.
    virtual std::map<std::uint16_t, double> changes() const { return {}; }
    virtual void restore(const std::map<std::uint16_t, double>& /*changes*/) {}
};

}  // namespace puckloop::camera
