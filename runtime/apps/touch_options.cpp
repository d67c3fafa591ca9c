// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/touch_options.hpp"

#include "runtime/apps/options/large_option.hpp"
#include "runtime/session/device_list.hpp"

namespace palpate::apps {

TouchHandles declare(cli::Command& command, TouchOptions& options) {
    const cli::Option asset = command.input("asset", options.asset, "the case (.vtkhdf)").required();
    command.input(
        "--trusted", options.trusted,
        "public keys (Ed25519, PEM): load the asset only if one of them has signed it; repeat for more");
    const cli::Option script =
        command.option("--script", options.script,
                       "what the hand does: press, slide, tremble, let-go, random or a file; of a forceps "
                       "'grasp', which pulls a rim out by --depth, or a file");
    command.option("--column", options.column,
                   "which column of the file, from 1, is one axis' motion: its smallest value clear of the "
                   "surface, its largest --depth deep");
    const cli::Option seconds = command.option(
        "--seconds", options.seconds, "how long, 0.001 to 86400; of a file, all unless this is given", "s");
    command.option("--depth", options.depth, "how deep the tool's surface goes below the rest surface", "mm");
    command.option("--speed", options.speed, "of press and slide", "mm/s");
    command.option("--body", options.body, "which body; the first deformable one if not given");
    command.option(
        "--target", options.target,
        "x,y,z: touch the surface point nearest to it; the most compliant place in reach if not given", "mm");
    command.option("--second", options.second,
                   "what a second tool on the same bodies does: a file as for --script");
    command.option("--scheme", options.scheme, "how contact is found: " + haptics::contact_method_names());
    declare(command, options.tool);
    declare_large_deformation(command, options.hyperelastic);
    command.option("--device", options.device,
                   session::device_usages([](const devices::DeviceKind&) { return true; }, true));
    command.option(
        "--shaft", options.shaft,
        "x,y,z: direction from the tip along the shaft of both tools, for a case with one; straight out "
        "of the target if not given, and with a file none, so that the tip alone is felt");
    command.option("--seed", options.seed, "of the scripts 'random' and 'tremble'");
    const cli::Option log = command.output("--log", options.log, "one row per tick (.csv)");
    const cli::Option curve = command.output("--curve", options.curve,
                                             "force and depth of the first tool over time; beyond two "
                                             "minutes the ticks of least and largest force (.svg)");
    command.option("--stream", options.stream,
                   "PORT or ADDRESS:PORT at which 3D Slicer and others see the session over OpenIGTLink");
    command.output("--record", options.record, "every tick, from the start on (.h5)");
    command.option("--record-seconds", options.record_seconds,
                   "how much of the run's end a recording holds: 51 MB a minute and tool", "s");
    const cli::Option replay = command.input(
        "--replay", options.replay,
        "recording to give the forces of again, as fast as possible; no option of a run goes with it (.h5)");
    command.flag("--virtual-clock", options.virtual_clock,
                 "tick as fast as possible; forces do not depend on the machine");
    return {asset, script, seconds, log, curve, replay};
}

}  // namespace palpate::apps
