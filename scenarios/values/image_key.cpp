#include "scenarios/values/image_key.h"

#include "base/files/shipped_files.h"

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

fs::path firmware_named(const fs::path& folder, const std::string& text, std::string_view board) {
    for (const Image& image : kImages)
        if (image.board == board && text == image.name) return shipped_image(image.file);
    std::error_code ignored;
    if (const fs::path file = folder / text; fs::exists(file, ignored)) return file;
    return shipped_image(text);
}

fs::path read_firmware(Reader& reader, std::string_view board) {
    const std::string text = reader.text("firmware");
    if (fs::path file = firmware_named(reader.folder(), text, board); !file.empty()) return file;
    std::string names;
    for (const Image& image : kImages) {
        if (image.board != board) continue;
        if (text == image.name)
            reader.fail("firmware", fmt::format("there is no {} beside this program", image.file),
                        "the firmware folder of the sources or of the installation");
        names += fmt::format("\"{}\", ", image.name);
    }
    if (text.find_first_of("./") == std::string::npos)
        reader.fail("firmware", fmt::format("there is no shipped image '{}' for this board", text),
                    "one of " + names + "or a file such as \"my.hex\"");
    return reader.folder() / text;
}

}  // namespace puckloop::scenarios
