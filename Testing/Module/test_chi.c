/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_test.h"

static void every_status_has_a_name_of_its_own(void)
{
  for (chi_status a = CHI_OK; a <= CHI_ERROR_NOT_READY; ++a)
  {
    CHECK(strcmp(chi_status_string(a), chi_status_string(-1)) != 0);
    for (chi_status b = CHI_OK; b < a; ++b)
    {
      CHECK(strcmp(chi_status_string(a), chi_status_string(b)) != 0);
    }
  }
}

static void sizes_are_those_of_the_c_types(void)
{
  CHECK(chi_type_size(CHI_F32) == sizeof(float) && chi_type_size(CHI_F64) == sizeof(double));
  CHECK(chi_type_size(CHI_I8) == 1 && chi_type_size(CHI_U8) == 1);
  CHECK(chi_type_size(CHI_I16) == 2 && chi_type_size(CHI_U16) == 2);
  CHECK(chi_type_size(CHI_I32) == 4 && chi_type_size(CHI_U32) == 4);
  CHECK(chi_type_size(CHI_I64) == 8 && chi_type_size(CHI_U64) == 8);
  CHECK(chi_type_size(0) == 0 && chi_type_size(11) == 0 && chi_type_size(-1) == 0);
}

int main(void)
{
  every_status_has_a_name_of_its_own();
  sizes_are_those_of_the_c_types();
  return chi_test_report();
}
