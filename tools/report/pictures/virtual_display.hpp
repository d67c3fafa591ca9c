// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <sys/types.h>

namespace palpate::report {

/// An X display to draw pictures on: the one DISPLAY names or, where none answers, an Xvfb of our own that
/// DISPLAY then names. The Xvfb ends with this object, and with this process however that ends.
class VirtualDisplay {
  public:
    /// Throws SystemFailure naming the package if Xvfb is missing or does not start. Not thread-safe: it
    /// changes the environment.
    VirtualDisplay();
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;
    ~VirtualDisplay();

    /// Process id of our own Xvfb; -1 if DISPLAY answered.
    pid_t server() const { return server_; }

  private:
    void* connection_ = nullptr;  // kept open: a server that loses its last client starts anew
    pid_t server_ = -1;
    std::string former_;
};

}  // namespace palpate::report
