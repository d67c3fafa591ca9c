// SPDX-License-Identifier: Apache-2.0
// What a made-up device library is made of.
extern "C" int palpate_stub;
int palpate_stub = 1;
