#include "run/control/control_socket.h"

#include "base/error.h"
#include "base/json.h"
#include "scenarios/reader/events/event_tables.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <thread>

namespace puckloop::tools {

namespace {

using boost::asio::local::stream_protocol;
using boost::system::error_code;

constexpr std::size_t kLongestLine = 64 * 1024;

class ControlSocket final : public physics::CommandSource {
  public:
    explicit ControlSocket(const std::string& path) : acceptor_(io_) {
        error_code error;
        acceptor_.open(stream_protocol(), error);
        // Before there is a file: Linux gives it the descriptor's mode, so at no time may others open it.
        if (!error && ::fchmod(acceptor_.native_handle(), S_IRUSR | S_IWUSR) != 0)
            error.assign(errno, boost::system::system_category());
        if (!error) acceptor_.bind(stream_protocol::endpoint(path), error);
        if (!error) acceptor_.listen(boost::asio::socket_base::max_listen_connections, error);
        if (error) throw RunError(fmt::format("{}: {}", path, error.message()));
        accept();
    }

    std::vector<physics::Command> poll() override {
        if (io_.stopped()) io_.restart();
        io_.poll();
        return std::exchange(heard_, {});
    }

    void reply(std::uint64_t id, const std::string& json) override {
        const auto client = clients_.find(id);
        if (client == clients_.end()) return;
        error_code gone;  // whoever asked may have left
        boost::asio::write(client->second->socket, boost::asio::buffer(json + "\n"), gone);
        clients_.erase(client);
    }

  private:
    struct Client {
        stream_protocol::socket socket;
        std::string text{};
    };

    void accept() {
        acceptor_.async_accept([this](const error_code& error, stream_protocol::socket socket) {
            if (!error) read(++last_id_, std::make_shared<Client>(Client{std::move(socket)}));
            accept();
        });
    }

    void read(std::uint64_t id, const std::shared_ptr<Client>& client) {
        clients_[id] = client;
        boost::asio::async_read_until(client->socket, boost::asio::dynamic_buffer(client->text, kLongestLine),
                                      '\n', [this, id, client](const error_code& error, std::size_t) {
                                          if (error)
                                              clients_.erase(id);
                                          else
                                              hear(id, client->text);
                                      });
    }

    /// Whoever sends it, only what a user could have typed gets any further: what is done is recorded as
    /// text.
    void hear(std::uint64_t id, const std::string& text) {
        try {
            const auto request = nlohmann::json::parse(text);
            physics::Command command{id};
            if (!request.value("list", false))
                command.action = scenarios::parse_command(request.at("act").get<std::string>());
            heard_.push_back(std::move(command));
        } catch (const InputError& error) {
            reply(id, nlohmann::json{{"refused", error.what()}}.dump());
        } catch (const nlohmann::json::exception&) {  // not what `puckloop act` sends
            reply(id, R"({"refused":"this is no command"})");
        }
    }

    boost::asio::io_context io_;
    stream_protocol::acceptor acceptor_;
    std::map<std::uint64_t, std::shared_ptr<Client>> clients_;
    std::vector<physics::Command> heard_;
    std::uint64_t last_id_ = 0;
};

}  // namespace

std::unique_ptr<physics::CommandSource> make_control_socket(const std::string& path) {
    return std::make_unique<ControlSocket>(path);
}

bool is_left_over(const std::string& path) {
    std::error_code ignored;  // any file refuses connections
    if (!std::filesystem::is_socket(std::filesystem::symlink_status(path, ignored))) return false;
    boost::asio::io_context io;
    stream_protocol::socket socket(io);
    error_code error;
    socket.connect(stream_protocol::endpoint(path), error);
    return error == boost::asio::error::connection_refused;
}

namespace {

/// A run that has just begun has its folder before the socket in it, and the socket before it listens.
error_code connect(stream_protocol::socket& socket, const std::string& path) {
    using std::chrono::steady_clock;
    constexpr std::chrono::milliseconds kUntilThere{5000}, kUntilListens{100};
    for (const auto begun = steady_clock::now();; std::this_thread::sleep_for(std::chrono::milliseconds(5))) {
        error_code error;
        std::error_code ignored;
        socket.connect(stream_protocol::endpoint(path), error);
        const auto waited = steady_clock::now() - begun;
        const bool soon_there =
            error == boost::system::errc::no_such_file_or_directory &&
            std::filesystem::is_directory(std::filesystem::path(path).parent_path(), ignored);
        const bool soon_listens = error == boost::asio::error::connection_refused;
        if (!(soon_there && waited < kUntilThere) && !(soon_listens && waited < kUntilListens)) return error;
        error_code closed;
        socket.close(closed);
    }
}

}  // namespace

std::string ask(const std::string& run, const std::string& path, const std::string& request, double seconds) {
    boost::asio::io_context io;
    stream_protocol::socket socket(io);
    error_code error = connect(socket, path);
    if (error == boost::asio::error::access_denied)
        throw InputError("", run, "belongs to another user", "a run of your own");
    if (error) throw InputError("", run, "the run has ended");
    std::string reply;
    bool over = false;
    boost::asio::async_write(
        socket, boost::asio::buffer(request), [&](const error_code& failed, std::size_t) {
            error = failed;
            if (failed) return;
            boost::asio::async_read_until(socket, boost::asio::dynamic_buffer(reply), '\n',
                                          [&](const error_code& lost, std::size_t) {
                                              error = lost;
                                              over = true;
                                          });
        });
    io.run_for(std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds)));
    if (error) throw InputError("", run, "the run ended before it replied");
    if (!over) throw RunError(fmt::format("{}: no reply for {:g} s", run, seconds));
    return reply;
}

}  // namespace puckloop::tools
