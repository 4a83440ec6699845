#pragma once
// A recorded run as pictures: one at an instant, or a film.

#include "view/recording/recording.h"

#include <optional>
#include <string>

namespace puckloop::tools {

struct FilmOptions {
    std::string file;                ///< ends with .png, .mp4 or .webm
    std::string part = "page";       ///< "page", "arena" or "timeline"
    double begin = 0.0;              ///< s; of a picture its instant
    std::optional<double> end;       ///< s; empty: of the run
    double speed = 1.0;              ///< times real time
    double rate = 30.0;              ///< pictures a second
    int width = 1400, height = 900;  ///< pixels of the page
    bool dark = false;
};

/// Throws InputError for what lies outside the run and where a program is not installed: Chromium or Chrome
/// draws, ffmpeg makes films. RunError where one of them fails; no half a file stays.
void write_film(const view::Recording& recording, const FilmOptions& options);

}  // namespace puckloop::tools
