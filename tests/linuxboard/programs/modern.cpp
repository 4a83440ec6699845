// The C++ side: std::thread, condition_variable with time-outs, futures, atomics that wait, random_device.
#include "serial.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <future>
#include <mutex>
#include <random>
#include <shared_mutex>
#include <thread>

using namespace std::chrono_literals;

int main() {
    const int fd = open_serial(1, 0);
    const auto say = [fd](char c) {
        if (write(fd, &c, 1) != 1) std::exit(4);
    };
    std::mutex mutex;
    std::condition_variable changed;
    bool ready = false;
    const auto start = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex);
    if (!changed.wait_for(lock, 5ms, [&] { return ready; })) say('T');
    std::thread setter([&] {
        std::this_thread::sleep_for(3ms);
        std::lock_guard guard(mutex);
        ready = true;
        changed.notify_one();
    });
    if (changed.wait_for(lock, 5ms, [&] { return ready; })) say('N');
    lock.unlock();
    setter.join();
    auto answer = std::async(std::launch::async, [] {
        std::this_thread::sleep_for(2ms);
        return 'F';
    });
    if (answer.wait_for(1ms) == std::future_status::timeout) say('W');
    say(answer.get());
    std::atomic<int> flag{0};
    std::thread waiter([&] {
        flag.wait(0);
        say('A');
    });
    std::this_thread::sleep_for(1ms);
    flag = 1;
    flag.notify_all();
    waiter.join();
    const auto took = std::chrono::steady_clock::now() - start;
    std::printf("%lld ms, random %u\n",
                static_cast<long long>(std::chrono::duration_cast<std::chrono::milliseconds>(took).count()),
                std::random_device{}());
    tcdrain(fd);
    return 0;
}
