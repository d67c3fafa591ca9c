// SPDX-License-Identifier: Apache-2.0
#include "runtime/realtime/servo_callbacks.hpp"

#include <stdexcept>
#include <string>
#include <thread>

namespace palpate::realtime {
namespace {

constexpr std::chrono::microseconds pause{100};

}  // namespace

ServoCallbacks::Handle ServoCallbacks::schedule(Function function, void* data) {
    for (std::size_t i = 0; i < most; ++i) {
        Slot& slot = slots_[i];
        State expected = State::free;
        if (!slot.state.compare_exchange_strong(expected, State::claimed)) continue;
        slot.function = function;
        slot.data = data;
        const Handle handle = slot.ended.load() * most + i;
        slot.state.store(State::scheduled);
        return handle;
    }
    throw std::length_error("servo callbacks: " + std::to_string(most) +
                            " functions are scheduled already; unschedule one first");
}

// The slot while the handle's function has not ended.
ServoCallbacks::Slot* ServoCallbacks::running_under(Handle handle) noexcept {
    Slot& slot = slots_[handle % most];
    return slot.ended.load() == handle / most ? &slot : nullptr;
}

void ServoCallbacks::unschedule(Handle handle) {
    while (Slot* slot = running_under(handle)) {
        State scheduled = State::scheduled, running = State::running;
        if (slot->state.compare_exchange_strong(scheduled, State::claimed)) {
            end(*slot);
            return;
        }
        slot->state.compare_exchange_strong(running, State::cancelled);
        std::this_thread::sleep_for(pause);
    }
}

bool ServoCallbacks::run(Function function, void* data, std::chrono::milliseconds patience) {
    const Handle handle = schedule(function, data);
    const auto until = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < until) {
        if (!running_under(handle)) return true;
        std::this_thread::sleep_for(pause);
    }
    while (Slot* slot = running_under(handle)) {
        State scheduled = State::scheduled;
        if (slot->state.compare_exchange_strong(scheduled, State::claimed)) {
            end(*slot);
            return false;
        }
        std::this_thread::sleep_for(pause);  // it runs just now, and may answer done
    }
    return true;
}

void ServoCallbacks::end(Slot& slot) noexcept {
    slot.ended.fetch_add(1);
    slot.state.store(State::free);
}

void ServoCallbacks::tick() noexcept {
    for (Slot& slot : slots_) {
        State scheduled = State::scheduled;
        if (!slot.state.compare_exchange_strong(scheduled, State::running)) continue;
        State running = State::running;
        if (slot.function(slot.data) == Then::done ||
            !slot.state.compare_exchange_strong(running, State::scheduled))
            end(slot);
    }
}

}  // namespace palpate::realtime
