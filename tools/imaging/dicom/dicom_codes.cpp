// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/dicom/dicom_codes.hpp"

#include <set>

namespace palpate::imaging {

std::string modality_code(const std::string& text) {
    static const std::set<std::string> codes{
        "ANN",        "AR",     "AS",         "ASMT",     "AU",     "BDUS",  "BI",       "BMD",
        "CD",         "CF",     "CFM",        "CP",       "CR",     "CS",    "CT",       "CTPROTOCOL",
        "DD",         "DF",     "DG",         "DM",       "DMS",    "DOC",   "DS",       "DX",
        "EC",         "ECG",    "EEG",        "EMG",      "EOG",    "EPS",   "ES",       "FA",
        "FID",        "FS",     "GM",         "HC",       "HD",     "IO",    "IOL",      "IVOCT",
        "IVUS",       "KER",    "KO",         "LEN",      "LP",     "LS",    "M3D",      "MA",
        "MG",         "MR",     "MS",         "NM",       "OAM",    "OCT",   "OP",       "OPM",
        "OPR",        "OPT",    "OPTBSV",     "OPTENF",   "OPV",    "OSS",   "OT",       "PA",
        "PLAN",       "POS",    "PR",         "PT",       "PX",     "REG",   "RESP",     "RF",
        "RG",         "RTDOSE", "RTIMAGE",    "RTINTENT", "RTPLAN", "RTRAD", "RTRECORD", "RTSEGANN",
        "RTSTRUCT",   "RWV",    "SC",         "SEG",      "SM",     "SMR",   "SR",       "SRF",
        "ST",         "STAIN",  "TEXTUREMAP", "TG",       "US",     "VA",    "VF",       "XA",
        "XAPROTOCOL", "XC"};
    return text.empty() || codes.contains(text) ? text : "other";
}

std::string photometric_code(const std::string& text) {
    static const std::set<std::string> codes{
        "ARGB",     "CMYK",         "HSV",     "MONOCHROME1",     "MONOCHROME2",     "PALETTE COLOR", "RGB",
        "YBR_FULL", "YBR_FULL_422", "YBR_ICT", "YBR_PARTIAL_420", "YBR_PARTIAL_422", "YBR_RCT"};
    return codes.contains(text) ? text : "other";
}

}  // namespace palpate::imaging
