#pragma once
// Automatic exposure and white balance of a camera: what a frame saw moves the gains of the next one.
//
// Exposure: the mean brightness of the picture returns to the reference. Each frame takes back a share of
// what is missing, so a step of the scene dies away geometrically; within a margin nothing moves. White
// balance: what is nearly grey becomes grey, red and blue by the same law.
//
// The e-puck library names the registers (reference, margins, speeds, bounds of exposure and of the white
// gains); what their numbers do is not public. Assumptions: 1. A speed is the share of the error per frame in
// sixteenths, and white balance takes an eighth. 2. A margin is in counts of the mean. 3. Where exposure time
// is at its longest an analogue gain of up to 4 goes on. 4. All of the picture counts alike. 5. Nearly grey
// is a pixel whose brightest colour is at most twice its darkest; with fewer than one pixel in 16 of these
// the balance holds.

#include <array>
#include <cstdint>
#include <span>

namespace puckloop::camera {

/// What a camera's registers ask for. Gains are over those of the default exposure.
struct AutomaticSettings {
    bool exposure = true, white = true;
    double reference = 0x70 / 255.0;           ///< mean brightness to be held, share of full scale
    double margin = 2.0 / 255.0;               ///< share of full scale within which exposure stays
    double rise = 8.0 / 16, fall = 12.0 / 16;  ///< share of the error per frame where it must grow, shrink
    double least = 0x0C / double{0x7CC}, most = 4.0;
    std::array<double, 2> white_least{0.25, 0.25}, white_most{3.5, 3.5};  ///< of red and blue, over green

    bool operator==(const AutomaticSettings&) const = default;
};

/// The light that a picture saw, before any gain.
struct SeenLight {
    std::array<std::array<std::uint32_t, 256>, 3> levels{};  ///< pixels by level, of red, green and blue
    std::array<std::uint64_t, 3> grey_sum{};                 ///< of the levels of nearly grey pixels
    std::uint64_t grey = 0, pixels = 0;

    /// Red, green and blue of each pixel.
    explicit SeenLight(std::span<const std::uint8_t> rgb);
    /// Mean brightness under these gains, full scale is 1: what saturates counts as full scale.
    double brightness(const std::array<double, 3>& gain) const;
};

class AutomaticControl {
  public:
    /// A frame with this light has passed; `manual`: gains that the registers set by hand.
    void frame(const SeenLight& light, const AutomaticSettings& settings,
               const std::array<double, 3>& manual);
    /// Gains of red, green and blue, with those that the registers set by hand.
    std::array<double, 3> gain(const AutomaticSettings& settings, const std::array<double, 3>& manual) const;
    void reset() { *this = {}; }

    template <class Archive>
    void state(Archive& archive) {
        archive.bounded(exposure_, 0.0, 1e6);
        for (double& white : white_)
            archive.bounded(white, 0.0, 1e6);
    }

  private:
    double exposure_ = 1.0;
    std::array<double, 2> white_{1.0, 1.0};  ///< red, blue
};

}  // namespace puckloop::camera
