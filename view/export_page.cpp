#include "view/export_page.h"

#include "base/error.h"
#include "base/json.h"
#include "view/page_parts.h"
#include "view/recording/bytes.h"
#include "view/recording/camera_pictures.h"

#include <fmt/format.h>
#include <zlib.h>

#include <span>
#include <vector>

namespace puckloop::view {

namespace {

constexpr std::string_view kStyleLink = "<link rel=\"stylesheet\" href=\"page.css\">";
constexpr std::string_view kScriptLink = "<script type=\"module\" src=\"page.js\"></script>";

void replace_once(std::string& text, std::string_view part, const std::string& by) {
    const std::size_t at = text.find(part);
    if (at == std::string::npos) throw RunError(fmt::format("the page has no '{}'", part));
    text.replace(at, part.size(), by);
}

/// All texts, each with its length (32 bits) before it.
std::string all_texts(const EventTable& table, std::size_t count) {
    constexpr std::size_t kPiece = 10'000;
    std::string out;
    for (std::size_t from = 0; from < count; from += kPiece) {
        std::vector<std::size_t> numbers;
        for (std::size_t i = from; i < std::min(count, from + kPiece); ++i)
            numbers.push_back(i);
        for (const std::string& text : table.texts(numbers)) {
            append_number(out, static_cast<std::uint32_t>(text.size()));
            out += text;
        }
    }
    return out;
}

}  // namespace

std::string base64(std::string_view bytes) {
    static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word = word << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
        for (int k = 3; k >= 0; --k)
            out += kLetters[word >> (6 * k) & 63U];
    }
    for (std::size_t k = 0; k < (3 - bytes.size() % 3) % 3; ++k)
        out[out.size() - 1 - k] = '=';
    return out;
}

std::string compressed(std::string_view bytes) {
    constexpr int kGzip = 15 + 16, kMemory = 8;
    z_stream stream{};
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
        throw RunError("cannot compress: no memory");
    std::string out, piece(1 << 16, '\0');
    std::size_t at = 0;
    int state = Z_OK;
    while (state == Z_OK) {
        constexpr std::size_t kMostIn = 1U << 30;
        const std::size_t in = std::min(kMostIn, bytes.size() - at);
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + at));
        stream.avail_in = static_cast<uInt>(in);
        stream.next_out = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_out = static_cast<uInt>(piece.size());
        state = deflate(&stream, at + in == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
        at += in - stream.avail_in;
        out.append(piece, 0, piece.size() - stream.avail_out);
    }
    deflateEnd(&stream);
    if (state != Z_STREAM_END) throw RunError("cannot compress");
    return out;
}

std::string exported_page(const Recording& recording, EventReader& events, std::size_t most) {
    events.wait();
    const EventTable& table = events.table();
    const std::size_t count = table.status().events;
    std::string data;
    const auto add = [&](const std::string& name, std::string_view bytes) {
        data += fmt::format("<script type=\"text/plain\" id=\"data-{}\">", name);
        data += base64(compressed(bytes));
        data += "</script>\n";
        if (data.size() > most)
            throw RunError(
                fmt::format("the page would have more than {} MB: export a shorter run, or view the "
                            "folder without --export",
                            most >> 20));
    };
    add("head", recording.head());
    add("poses", recording.poses());
    add("status", events.status());
    add("beams", events.beams());
    add("trails", recording.trails());
    std::string tracked;
    for (std::string part; !(part = recording.tail(Recording::Rows::Tracker, tracked.size())).empty();)
        tracked += part;
    add("tracked", tracked);
    std::vector<std::string> robots(recording.stations().begin(),
                                    recording.stations().begin() +
                                        static_cast<std::ptrdiff_t>(recording.robots()));
    const std::string list = camera_list(recording.folder(), robots);
    nlohmann::json cameras = nlohmann::json::parse(list);
    std::size_t pictures = 0;  // bytes
    for (nlohmann::json& camera : cameras) {
        nlohmann::json times = nlohmann::json::array(), frames = nlohmann::json::array();
        const auto number = camera.at("camera").get<std::size_t>();
        for (std::size_t i = 0; i < camera.at("frame").size(); ++i) {
            const auto frame = camera.at("frame")[i].get<std::size_t>();
            const auto picture = camera_picture(recording.folder(), robots, number, frame);
            if (!picture || (pictures += picture->size()) > kMostExportedPictures) continue;
            add(fmt::format("picture-{}-{}", number, frame), *picture);
            times.push_back(camera.at("t")[i]);
            frames.push_back(frame);
        }
        camera["t"] = std::move(times);
        camera["frame"] = std::move(frames);
    }
    add("cameras", cameras.dump());
    add("leds", events.leds(0, EventReader::kMostLeds));
    add("events", table.block(0, count));
    add("texts", all_texts(table, count));
    for (std::size_t robot = 0; robot < recording.robots(); ++robot)
        add(fmt::format("sensors-{}", robot), recording.sensors(robot));
    std::string page(page_html());
    replace_once(page, kStyleLink, fmt::format("<style>\n{}</style>", page_style()));
    replace_once(page, kScriptLink,
                 data + fmt::format("<script type=\"module\">\n{}</script>", page_script()));
    return page;
}

}  // namespace puckloop::view
