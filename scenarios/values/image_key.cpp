#include "scenarios/values/image_key.h"

#include "base/shipped_files.h"

#include <fmt/format.h>

#include <array>
#include <string>

namespace puckloop::scenarios {

namespace fs = std::filesystem;

namespace {

struct Image {
    std::string_view board, name, file;
};

constexpr auto kImages = std::to_array<Image>({
    {"pic", "own", "epuck.hex"},
    {"pic", "ircom", "epuck_ircom.hex"},
    {"pic", "sound", "sound.hex"},
    {"pic", "ears", "ears.hex"},
    {"pic", "bluetooth", "talk.hex"},
    {"pic", "network", "network.hex"},
    {"pic", "camera", "camera.hex"},
    {"pic", "can", "can.hex"},
    {"rab", "own", "rab.hex"},
    {"rab", "can", "ecan.hex"},
});

}  // namespace

fs::path read_firmware(Reader& reader, std::string_view board) {
    const std::string text = reader.text("firmware");
    std::string names;
    for (const Image& image : kImages) {
        if (image.board != board) continue;
        if (text == image.name) {
            fs::path file = shipped_image(image.file);
            if (file.empty())
                reader.fail("firmware", fmt::format("there is no {} beside this program", image.file),
                            "the firmware folder of the sources or of the installation");
            return file;
        }
        names += fmt::format("\"{}\", ", image.name);
    }
    const fs::path file = reader.folder() / text;
    std::error_code ignored;
    if (fs::exists(file, ignored)) return file;
    if (fs::path image = shipped_image(text); !image.empty()) return image;
    if (text.find_first_of("./") == std::string::npos)
        reader.fail("firmware", fmt::format("there is no shipped image '{}' for this board", text),
                    "one of " + names + "or a file such as \"my.hex\"");
    return file;
}

}  // namespace puckloop::scenarios
