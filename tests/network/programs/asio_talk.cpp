// A server and its clients on Boost.Asio that know of no emulator: lines there, answers back, a datagram, a
// timer beside. `asio_talk server PORT COUNT` ends after COUNT clients, `asio_talk client HOST PORT NAME`
// after three lines.

#include <utility>

#include <boost/asio.hpp>

#include <chrono>
#include <functional>
#include <iostream>
#include <memory>
#include <string>

using boost::asio::ip::tcp;
using boost::asio::ip::udp;
using Error = boost::system::error_code;

namespace {

struct Session : std::enable_shared_from_this<Session> {
    tcp::socket socket;
    boost::asio::streambuf input;
    std::string answer;
    int& left;

    Session(tcp::socket taken, int& clients) : socket(std::move(taken)), left(clients) {}

    void read(boost::asio::io_context& io) {
        auto self = shared_from_this();
        boost::asio::async_read_until(socket, input, '\n', [self, &io](Error error, std::size_t) {
            if (error) {
                std::cout << "gone: " << error.message() << std::endl;
                if (--self->left == 0) io.stop();
                return;
            }
            std::string line;
            std::istream stream(&self->input);
            std::getline(stream, line);
            std::cout << "line " << line << std::endl;
            self->answer = "got " + line + "\n";
            boost::asio::async_write(self->socket, boost::asio::buffer(self->answer),
                                     [self, &io](Error, std::size_t) { self->read(io); });
        });
    }
};

void accept(boost::asio::io_context& io, tcp::acceptor& acceptor, int& left) {
    acceptor.async_accept([&](Error error, tcp::socket socket) {
        if (error) return;
        std::make_shared<Session>(std::move(socket), left)->read(io);
        accept(io, acceptor, left);
    });
}

void tick(boost::asio::steady_timer& timer, int& ticks) {
    timer.expires_after(std::chrono::milliseconds(50));
    timer.async_wait([&](Error error) {
        if (error) return;
        ++ticks;
        tick(timer, ticks);
    });
}

int serve(unsigned short port, int clients) {
    boost::asio::io_context io;
    tcp::acceptor acceptor(io, tcp::endpoint(tcp::v4(), port));
    boost::asio::steady_timer timer(io);
    int ticks = 0;
    accept(io, acceptor, clients);
    tick(timer, ticks);
    io.run();
    std::cout << "ticks " << ticks << std::endl;
    return 0;
}

int talk(const std::string& host, const std::string& port, const std::string& name) {
    boost::asio::io_context io;
    tcp::resolver resolver(io);
    tcp::socket socket(io);
    int sent = 0;
    std::string line;
    boost::asio::streambuf input;
    boost::asio::steady_timer pause(io);
    std::function<void()> next = [&] {
        if (sent == 3) return socket.close();
        line = name + " " + std::to_string(sent++) + "\n";
        boost::asio::async_write(socket, boost::asio::buffer(line), [&](Error, std::size_t) {
            boost::asio::async_read_until(socket, input, '\n', [&](Error error, std::size_t) {
                std::string answer;
                std::istream stream(&input);
                std::getline(stream, answer);
                std::cout << (error ? error.message() : answer) << std::endl;
                pause.expires_after(std::chrono::milliseconds(30));
                pause.async_wait([&](Error) { next(); });
            });
        });
    };
    resolver.async_resolve(host, port, [&](Error error, const tcp::resolver::results_type& places) {
        if (error) {
            std::cout << error.message() << std::endl;
            return;
        }
        boost::asio::async_connect(socket, places, [&](Error failed, const tcp::endpoint&) {
            if (failed)
                std::cout << failed.message() << std::endl;
            else
                next();
        });
    });
    io.run();
    return 0;
}

}  // namespace

int main(int count, char** words) {
    const std::string role = count > 1 ? words[1] : "";
    if (role == "server" && count == 4)
        return serve(static_cast<unsigned short>(std::stoi(words[2])), std::stoi(words[3]));
    if (role == "client" && count == 5) return talk(words[2], words[3], words[4]);
    return 2;
}
