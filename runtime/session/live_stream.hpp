// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/openigtlink/session_stream.hpp"

namespace palpate::session {

/// A session shown live over OpenIGTLink, its contact points where they are on the surfaces at rest.
class LiveStream {
  public:
    /// Listens at `address`, "PORT" or "ADDRESS:PORT". The case must outlive this. Throws as SessionStream.
    LiveStream(const std::string& address, const Case& patient_case, std::size_t tool_count);

    /// Takes what a tick saw of one tool. From one thread, not the servo's.
    void show(const TickResult& result) noexcept;

  private:
    const Case& case_;
    openigtlink::SessionStream stream_;
};

}  // namespace palpate::session
