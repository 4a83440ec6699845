// `puckloop images`: third-party images, where they come from, and whether PUCKLOOP_IMAGES has them.

#include "base/error.h"
#include "base/json.h"
#include "base/sha256.h"
#include "base/text/suggest.h"
#include "tools/cli/command.h"
#include "tools/guide/guide.h"
#include "tools/guide/image_catalogue.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct ImagesOptions {
    std::string name;
    bool json = false;
};

enum class Found { NoFolder, Missing, Other, Same };

Found look_for(const CataloguedImage& image) {
    const fs::path folder = images_folder();
    if (folder.empty()) return Found::NoFolder;
    const fs::path file = folder / image.file;
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return Found::Missing;
    return sha256_of_file(file) == image.sha256 ? Found::Same : Found::Other;
}

const char* text_of(Found found) {
    switch (found) {
    case Found::NoFolder:
        return "unknown";
    case Found::Missing:
        return "missing";
    case Found::Other:
        return "another file of this name";
    case Found::Same:
        return "there";
    }
    return "";
}

std::string command_of(const CataloguedImage& image) {
    std::string command(image.command);
    const std::size_t at = command.find("IMAGE");
    const fs::path folder = images_folder();
    const std::string file =
        folder.empty() ? "$PUCKLOOP_IMAGES/" + std::string(image.file) : (folder / image.file).string();
    return at == std::string::npos ? command : command.replace(at, std::string_view("IMAGE").size(), file);
}

ordered_json as_json(const CataloguedImage& image) {
    const Found found = look_for(image);
    return {{"name", image.file},
            {"about", image.about},
            {"board", image.board},
            {"boot", image.boot},
            {"repository", fmt::format("https://github.com/{}", image.repository)},
            {"path", image.path},
            {"sha256", image.sha256},
            {"found", text_of(found)},
            {"file", found == Found::Same ? (images_folder() / image.file).string() : ""},
            {"command", command_of(image)}};
}

void print(const CataloguedImage& image) {
    fmt::print("{}: {}\n", image.file, image.about);
    fmt::print("  board       {}\n", image.board);
    if (!image.boot.empty()) fmt::print("  boots in    {}\n", image.boot);
    fmt::print("  repository  https://github.com/{}\n  path        {}\n  sha256      {}\n", image.repository,
               image.path, image.sha256);
    fmt::print("  here        {}\n  command     {}\n", text_of(look_for(image)), command_of(image));
}

int show(const ImagesOptions& options) {
    std::vector<const CataloguedImage*> shown;
    std::vector<std::string_view> names;
    for (const CataloguedImage& image : catalogued_images()) {
        names.push_back(image.file);
        if (options.name.empty() || options.name == image.file) shown.push_back(&image);
    }
    if (shown.empty())
        throw InputError("", "images", fmt::format("no image '{}' is known", options.name),
                         "puckloop images lists them" + did_you_mean(options.name, names));
    std::error_code error;
    if (const fs::path folder = images_folder(); !folder.empty() && !fs::is_directory(folder, error))
        throw InputError(folder.string(), "PUCKLOOP_IMAGES", "is no folder", "the folder of your images");
    if (options.json) {
        ordered_json list = ordered_json::array();
        for (const CataloguedImage* image : shown)
            list.push_back(as_json(*image));
        fmt::print("{}\n", ordered_json{{"format", 1}, {"images", list}}.dump(2));
        return 0;
    }
    for (const CataloguedImage* image : shown)
        print(*image);
    if (images_folder().empty())
        fmt::print("Put the files into one folder and name it in PUCKLOOP_IMAGES.\n");
    return 0;
}

}  // namespace

void declare_images(Command& app, int& status) {
    auto options = std::make_shared<ImagesOptions>();
    Command* command = app.add_subcommand(
        "images", "third-party firmware images: where they come from, and what works with them");
    command->add_option("name", options->name, "only this one")->type_name("NAME");
    command->add_flag("--json", options->json, "print one JSON object");
    command->footer("None of them comes with puckloop. PUCKLOOP_IMAGES names the folder with yours.");
    command->callback([options, &status] { status = show(*options); });
}

}  // namespace puckloop::tools
