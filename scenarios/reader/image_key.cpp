#include "scenarios/reader/image_key.h"

#include "base/shipped_files.h"

#include <fmt/format.h>

#include <string>

namespace puckloop::scenarios {

namespace fs = std::filesystem;

fs::path read_firmware(Reader& reader, const fs::path& folder, std::string_view own) {
    const std::string name = reader.text("firmware");
    if (name == "own") {
        fs::path image = shipped_image(own);
        if (image.empty())
            reader.fail("firmware", fmt::format("there is no {} beside this program", own),
                        "the firmware folder of the sources or of the installation");
        return image;
    }
    std::error_code error;
    if (fs::path file = folder / name; fs::exists(file, error)) return file;
    if (fs::path image = shipped_image(name); !image.empty()) return image;
    return folder / name;
}

}  // namespace puckloop::scenarios
