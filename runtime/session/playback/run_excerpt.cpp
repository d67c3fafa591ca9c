// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/playback/run_excerpt.hpp"

#include <utility>

namespace palpate::session {

using recording::Recording;

void RunExcerpt::add(const TickResult& tick) {
    if (tick.tick % every_ != 0) return;
    if (kept_.ticks.size() >= most_rows || kept_.contacts.size() + max_contacts > most_contacts) thin();
    if (tick.tick % every_ == 0) append(tick, tick.active_contacts());
}

void RunExcerpt::append(const Tick& tick, std::span<const Contact> contacts) {
    kept_.ticks.push_back(tick);
    kept_.ticks.back().first_contact = std::ssize(kept_.contacts);
    kept_.contacts.insert(kept_.contacts.end(), contacts.begin(), contacts.end());
}

void RunExcerpt::thin() {
    const Recording all = take();
    every_ = 2 * all.head.every;
    for (const Tick& tick : all.ticks)
        if (tick.tick % every_ == 0) append(tick, all.contacts_of(tick));
}

Recording RunExcerpt::take() {
    Recording all = std::exchange(kept_, {});
    all.head.every = std::exchange(every_, first_every);
    return all;
}

}  // namespace palpate::session
