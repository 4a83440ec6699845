#pragma once
// The main board's camera: a PO3030K, PO6030K or PO8030D at its I2C address, its reset line, and its eight
// data lines with VSYNC, HREF and pixel clock. It never ticks: lines are computed when somebody looks, and
// the scene is drawn when the first byte of a frame is looked at.
//
// Deviations
// 1. A picture is of the instant at which its first byte is looked at, all pixels at once: no rolling
//    shutter, no motion blur. It is drawn at the number of pixels that come out.
// 2. The master clock is the chip's instruction clock (14.7456 MHz on the board, where both come from one
//    crystal), whatever the chip's oscillator does to it.
// 3. A write that changes the timing begins a new frame at once.
// 4. U and V of Y U Y V are those of the pixel that they come with.
// 5. Without HREF the data lines are low. PCLK runs all the time.
// 6. Frames that nobody looks at are not drawn: automatic exposure and white balance take what the next one
//    that is drawn sees for what those saw.

#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "emu/camera/model.h"
#include "emu/camera/scenery.h"
#include "emu/camera/video_timing.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::camera {

/// A frame of which at least one byte was looked at.
struct TakenFrame {
    Cycle cycle = 0;          ///< of the first byte
    std::uint64_t frame = 0;  ///< since the timing was last set
    PixelFormat format = PixelFormat::Rgb565;
    std::uint32_t step = 1;
    std::int32_t column = 0, row = 0;  ///< of the array's pixel where HREF begins
    std::uint64_t hash = 0;            ///< FNV-1a of the picture's red, green and blue bytes
    double gain = 1.0;  ///< of green: what light was multiplied with, 1 at the default exposure

    template <class Archive>
    void state(Archive& archive) {
        archive(cycle, frame);
        archive.bounded(format, PixelFormat::Rgb565, PixelFormat::Grey);
        archive(step, column, row, hash);
        archive.bounded(gain, 0.0, 1e12);
    }
};
std::string_view name_of(PixelFormat format);

/// What is on the board. Early boards carry the PO3030K on its side, so that rows run from the left to the
/// right of what is seen: 480 columns wide and 640 rows high (EEPROM's last word is 3 there).
struct Fitting {
    Model model = Model::Po3030k;
    bool turned = false;
};

class Camera {
  public:
    struct Picture {
        std::uint32_t width = 0, height = 0;
        std::vector<std::uint8_t> rgb;
    };

    /// `scenery` outlives it; of a turned camera it is asked for pictures of the turned field of view.
    Camera(const Fitting& fitting, Scenery& scenery);

    Model model() const { return model_; }
    Scenery& scenery() { return scenery_; }
    /// Level of the reset line from cycle `now` on; low at the start.
    void set_reset(bool high, Cycle now);
    bool running() const { return running_; }

    /// A phase of the bus's master. Returns the answer if the camera is addressed, nothing if it is not, or
    /// none is due (Stop). `now`: from when on a register that is written counts.
    std::optional<cosim::I2cPhase> i2c(const cosim::I2cPhase& phase, Cycle now);
    /// The transfer under way is with the camera.
    bool selected() const { return selected_; }
    /// A write moved the edges of the lines since the last call.
    bool edges_moved() { return std::exchange(edges_moved_, false); }

    bool vsync(Cycle now) const { return timed(now) && timing_.vsync(now); }
    bool href(Cycle now) const { return timed(now) && timing_.href(now); }
    bool pclk(Cycle now) const { return timed(now) && timing_.pclk(now); }
    /// Looks at the data lines.
    std::uint8_t data(Cycle now);
    /// The same without taking a picture: 0 where none of this frame was taken yet.
    std::uint8_t quiet_data(Cycle now) const;
    Cycle next_vsync(Cycle after) const { return running_ ? timing_.next_vsync(after) : kNoCycle; }
    Cycle next_href(Cycle after) const { return running_ ? timing_.next_href(after) : kNoCycle; }
    Cycle next_byte(Cycle after) const { return running_ ? timing_.next_byte(after) : kNoCycle; }

    const VideoMode& mode() const { return mode_; }
    std::uint8_t peek(std::uint8_t bank, std::uint8_t number) const {
        return registers_[index(bank, number)];
    }
    const std::vector<TakenFrame>& frames() const { return frames_; }

    /// What was seen in the last of them, as wide and high as the scenery was drawn; empty before the first.
    const Picture& last_picture() const { return pictures_[pictures_taken_ % kPictures]; }

    template <class Archive>
    void state(Archive& archive) {
        archive(registers_, number_, number_next_, selected_, running_, edges_moved_, start_,
                pictures_taken_);
        archive(taken_frame_, automatic_);
        archive.grows(frames_);
        if constexpr (!Archive::kRaw) state_of_pictures(archive);
        if constexpr (Archive::kLoads) set_mode();
    }

  private:
    static constexpr std::size_t kPictures = 4;  // as many as a board that goes back can be behind

    template <class Archive>
    void state_of_pictures(Archive& archive) {
        Picture& picture = pictures_[pictures_taken_ % kPictures];
        archive.bounded(picture.width, 0, kArrayWidth);
        archive.bounded(picture.height, 0, kArrayWidth);
        archive(picture.rgb);
        archive.check(picture.rgb.size() == 3u * picture.width * picture.height, "a picture of another size");
        auto changes = scenery_.changes();
        archive(changes);
        if constexpr (Archive::kLoads) scenery_.restore(changes);
    }
    static constexpr std::size_t index(std::uint8_t bank, std::uint8_t number) {
        return bank * kBankSize + number;
    }
    bool timed(Cycle now) const { return running_ && now >= start_; }
    std::uint8_t bank() const;
    void write(std::uint8_t value, Cycle now);
    void restart(Cycle now);
    void set_mode();
    void take(Cycle now);
    void expose(Picture& picture, const std::array<double, 3>& gain) const;
    std::uint8_t byte_at(const VideoTiming::Place& place) const;

    Model model_;
    bool turned_;
    Scenery& scenery_;
    Registers registers_;
    std::uint8_t number_ = 0;  ///< register that the next byte is about
    bool number_next_ = false, selected_ = false;
    bool running_ = false, edges_moved_ = false;
    Cycle start_ = 0;  ///< of frame 0
    std::uint64_t pictures_taken_ = 0;
    std::optional<std::uint64_t> taken_frame_;  ///< whose picture is the last one taken
    std::vector<TakenFrame> frames_;
    AutomaticControl automatic_;

    // These follow from the rest, or are kept for as long as a board may go back.
    VideoMode mode_;
    VideoTiming timing_;
    std::array<Picture, kPictures> pictures_;
};

}  // namespace puckloop::camera
