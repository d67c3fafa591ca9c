// SPDX-License-Identifier: Apache-2.0
#include "runtime/sound/force_sound.hpp"

#include <AL/al.h>
#include <AL/alc.h>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "formats/model/errors.hpp"
#include "runtime/sound/force_pitch.hpp"

namespace palpate::sound {
namespace {

constexpr int sample_rate = 44100;    // Hz
constexpr double stored_pitch = 220;  // Hz: whole periods in a second, so that it repeats without a seam

// A second of a tone whose overtones are heard where a laptop's speakers leave the ground tone out.
std::vector<std::int16_t> one_second() {
    constexpr std::array<double, 4> overtones{0.5, 0.25, 0.12, 0.06};
    std::vector<std::int16_t> samples(sample_rate);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        double sum = 0;
        for (std::size_t n = 0; n < overtones.size(); ++n)
            sum += overtones[n] * std::sin(2 * std::numbers::pi * stored_pitch * static_cast<double>(n + 1) *
                                           static_cast<double>(i) / sample_rate);
        samples[i] = static_cast<std::int16_t>(std::lround(sum * INT16_MAX));
    }
    return samples;
}

SystemFailure no_sound() {
    return SystemFailure({.culprit = "sound",
                          .found = "nothing plays sound here",
                          .expected = "",
                          .next_step = "connect speakers or look at the desktop's sound settings"});
}

}  // namespace

// A tone that repeats for ever; pitch and loudness are what changes.
class ForceSound::Player {
  public:
    Player() : device_(alcOpenDevice(nullptr), alcCloseDevice) {
        if (!device_) throw no_sound();
        context_ = {alcCreateContext(device_.get(), nullptr), leave};
        if (!context_ || !alcMakeContextCurrent(context_.get())) throw no_sound();
        alGenBuffers(1, &tone_);
        const std::vector<std::int16_t> samples = one_second();
        alBufferData(tone_, AL_FORMAT_MONO16, samples.data(),
                     static_cast<ALsizei>(samples.size() * sizeof(samples.front())), sample_rate);
        alGenSources(1, &source_);
        alSourcei(source_, AL_BUFFER, static_cast<ALint>(tone_));
        alSourcei(source_, AL_LOOPING, AL_TRUE);
        alSourcef(source_, AL_GAIN, 0);
        alSourcePlay(source_);
        if (alGetError() != AL_NO_ERROR) throw no_sound();
    }

    ~Player() {
        alDeleteSources(1, &source_);
        alDeleteBuffers(1, &tone_);
    }

    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    void play(const Tone& tone) {
        alSourcef(source_, AL_PITCH, static_cast<float>(tone.pitch / stored_pitch));
        alSourcef(source_, AL_GAIN, static_cast<float>(tone.loudness));
    }

  private:
    static void leave(ALCcontext* context) {
        alcMakeContextCurrent(nullptr);
        alcDestroyContext(context);
    }

    std::unique_ptr<ALCdevice, ALCboolean (*)(ALCdevice*)> device_;
    std::unique_ptr<ALCcontext, void (*)(ALCcontext*)> context_{nullptr, leave};
    ALuint tone_ = 0, source_ = 0;
};

ForceSound::ForceSound() = default;
ForceSound::~ForceSound() = default;

void ForceSound::turn() {
    if (player_)
        player_.reset();
    else
        player_ = std::make_unique<Player>();
}

void ForceSound::follow(double newtons) {
    if (player_) player_->play(tone_of(newtons));
}

}  // namespace palpate::sound
