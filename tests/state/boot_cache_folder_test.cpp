// The cache's folder: where it is, whom it belongs to, how much it holds.

#include "run/states/boot_cache.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>

#include <sys/stat.h>

using namespace puckloop;
using namespace puckloop::tools;
namespace fs = std::filesystem;

namespace {

/// An environment variable for as long as this lives.
class Variable {
  public:
    Variable(const char* name, const char* value) : name_(name) {
        if (const char* old = std::getenv(name)) old_ = old;
        set(value);
    }
    ~Variable() { set(old_ ? old_->c_str() : nullptr); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

  private:
    void set(const char* value) { value ? ::setenv(name_, value, 1) : ::unsetenv(name_); }
    const char* name_;
    std::optional<std::string> old_;
};

}  // namespace

TEST_CASE("where the cache is") {
    const Variable home("HOME", "/home/somebody"), xdg("XDG_CACHE_HOME", nullptr),
        own("PUCKLOOP_CACHE", nullptr);
    const CacheFolder at_home{"/home/somebody/.cache/puckloop"};
    CHECK(cache_folder() == at_home);
    {
        const Variable there("XDG_CACHE_HOME", "/var/cache/me");
        CHECK(cache_folder() == CacheFolder{"/var/cache/me/puckloop"});
        const Variable named("PUCKLOOP_CACHE", "/tmp/x");
        CHECK(cache_folder() == CacheFolder{"/tmp/x", true});
        const Variable off("PUCKLOOP_CACHE", "off");
        CHECK(!cache_folder());
        const Variable empty("PUCKLOOP_CACHE", "");
        CHECK(!cache_folder());
    }
    const Variable relative("XDG_CACHE_HOME", "cache");
    CHECK(cache_folder() == at_home);
    const Variable nowhere("HOME", nullptr);
    CHECK(cache_folder() == CacheFolder{});
    CHECK_THAT(prepare_cache({}), Catch::Contains("HOME"));
}

TEST_CASE("a cache that others may write to is not used") {
    const fs::path folder = tests::scratch_path("cache");
    CHECK(prepare_cache(folder / "deep").empty());
    struct stat info {};
    REQUIRE(::stat((folder / "deep").c_str(), &info) == 0);
    CHECK((info.st_mode & 0777) == 0700);
    REQUIRE(::chmod((folder / "deep").c_str(), 0777) == 0);
    CHECK(prepare_cache(folder / "deep") == "others may write there");
    fs::remove_all(folder);
}

TEST_CASE("what was not used for longest goes first") {
    const fs::path folder = tests::scratch_path("cache");
    REQUIRE(prepare_cache(folder).empty());
    const auto now = fs::file_time_type::clock::now();
    for (int i = 0; i < 5; ++i) {
        const fs::path file = folder / (std::to_string(i) + ".state");
        std::ofstream(file) << std::string(1000, 'x');
        fs::last_write_time(file, now - std::chrono::hours(i == 4 ? 0 : 10 - i));
    }
    std::ofstream(folder / "README") << std::string(5000, 'x');  // not ours
    prune_cache(folder, 2500);
    CHECK(!fs::exists(folder / "0.state"));
    CHECK(!fs::exists(folder / "1.state"));
    CHECK(!fs::exists(folder / "2.state"));
    CHECK(fs::exists(folder / "3.state"));
    CHECK(fs::exists(folder / "4.state"));
    CHECK(fs::exists(folder / "README"));
    prune_cache(folder / "absent", 0);
    fs::remove_all(folder);
}

TEST_CASE("another board, build, length or world is another file") {
    const cosim::BoardIdentity board{"robot0.pic", "kind", "chip", "image", "{}"};
    const auto name = [](const cosim::BoardIdentity& of, cosim::Time length, const std::string& world) {
        return cached_boot("/c", of, length, world).string();
    };
    const std::string one = name(board, 5, "w");
    CHECK(one == name(board, 5, "w"));
    CHECK(one.starts_with("/c/"));
    CHECK(one.ends_with(".state"));
    CHECK(one != name(board, 6, "w"));
    CHECK(one != name(board, 5, "v"));
    cosim::BoardIdentity other = board;
    other.image = "imagf";
    CHECK(one != name(other, 5, "w"));
    other = board;
    other.parameters = "{\"seed\":2}";
    CHECK(one != name(other, 5, "w"));
}
