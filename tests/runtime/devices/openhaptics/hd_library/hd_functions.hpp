// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <dlfcn.h>
#include <stdexcept>
#include <string>

#include "tests/runtime/devices/openhaptics/hd_library/hd_types.hpp"

namespace palpate::hd {

/// The conformance library as an application finds it; stays loaded, as a driver must.
/// Throws std::runtime_error
/// where it cannot be loaded or lacks a function.
class Functions {
  public:
    explicit Functions(const std::string& path) : object_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
        if (!object_) throw std::runtime_error(dlerror());
        load(hdInitDevice, "hdInitDevice");
        load(hdDisableDevice, "hdDisableDevice");
        load(hdMakeCurrentDevice, "hdMakeCurrentDevice");
        load(hdGetCurrentDevice, "hdGetCurrentDevice");
        load(hdBeginFrame, "hdBeginFrame");
        load(hdEndFrame, "hdEndFrame");
        load(hdGetError, "hdGetError");
        load(hdGetErrorString, "hdGetErrorString");
        load(hdEnable, "hdEnable");
        load(hdDisable, "hdDisable");
        load(hdIsEnabled, "hdIsEnabled");
        load(hdGetBooleanv, "hdGetBooleanv");
        load(hdGetIntegerv, "hdGetIntegerv");
        load(hdGetFloatv, "hdGetFloatv");
        load(hdGetDoublev, "hdGetDoublev");
        load(hdGetLongv, "hdGetLongv");
        load(hdGetString, "hdGetString");
        load(hdSetBooleanv, "hdSetBooleanv");
        load(hdSetIntegerv, "hdSetIntegerv");
        load(hdSetFloatv, "hdSetFloatv");
        load(hdSetDoublev, "hdSetDoublev");
        load(hdSetLongv, "hdSetLongv");
        load(hdCheckCalibration, "hdCheckCalibration");
        load(hdCheckCalibrationStyle, "hdCheckCalibrationStyle");
        load(hdUpdateCalibration, "hdUpdateCalibration");
        load(hdStartScheduler, "hdStartScheduler");
        load(hdStopScheduler, "hdStopScheduler");
        load(hdSetSchedulerRate, "hdSetSchedulerRate");
        load(hdScheduleAsynchronous, "hdScheduleAsynchronous");
        load(hdScheduleSynchronous, "hdScheduleSynchronous");
        load(hdUnschedule, "hdUnschedule");
        load(hdWaitForCompletion, "hdWaitForCompletion");
        load(hdGetSchedulerTimeStamp, "hdGetSchedulerTimeStamp");
        load(configure, "palpate_hd_configure");
        load(hardware, "palpate_hd_hardware");
    }
    Functions(const Functions&) = delete;
    Functions& operator=(const Functions&) = delete;

    Handle (*hdInitDevice)(const char*);
    void (*hdDisableDevice)(Handle);
    void (*hdMakeCurrentDevice)(Handle);
    Handle (*hdGetCurrentDevice)();
    void (*hdBeginFrame)(Handle);
    void (*hdEndFrame)(Handle);
    ErrorInfo (*hdGetError)();
    const char* (*hdGetErrorString)(unsigned);
    void (*hdEnable)(unsigned);
    void (*hdDisable)(unsigned);
    unsigned char (*hdIsEnabled)(unsigned);
    void (*hdGetBooleanv)(unsigned, unsigned char*);
    void (*hdGetIntegerv)(unsigned, int*);
    void (*hdGetFloatv)(unsigned, float*);
    void (*hdGetDoublev)(unsigned, double*);
    void (*hdGetLongv)(unsigned, long*);
    const char* (*hdGetString)(unsigned);
    void (*hdSetBooleanv)(unsigned, const unsigned char*);
    void (*hdSetIntegerv)(unsigned, const int*);
    void (*hdSetFloatv)(unsigned, const float*);
    void (*hdSetDoublev)(unsigned, const double*);
    void (*hdSetLongv)(unsigned, const long*);
    unsigned (*hdCheckCalibration)();
    unsigned (*hdCheckCalibrationStyle)();
    void (*hdUpdateCalibration)(unsigned);
    void (*hdStartScheduler)();
    void (*hdStopScheduler)();
    void (*hdSetSchedulerRate)(unsigned long);
    unsigned long (*hdScheduleAsynchronous)(Callback, void*, unsigned short);
    void (*hdScheduleSynchronous)(Callback, void*, unsigned short);
    void (*hdUnschedule)(unsigned long);
    unsigned char (*hdWaitForCompletion)(unsigned long, unsigned);
    double (*hdGetSchedulerTimeStamp)();
    const char* (*configure)(const char*);
    Hardware (*hardware)(Handle);

  private:
    template <class Function>
    void load(Function*& function, const char* name) {
        function = reinterpret_cast<Function*>(dlsym(object_, name));
        if (!function) throw std::runtime_error(std::string("no ") + name);
    }

    void* object_;
};

}  // namespace palpate::hd
