using System;
using System.Runtime.InteropServices;

namespace Pacinian
{
    /// <summary>What Linux tells of users and files; elsewhere nothing is told.</summary>
    internal static class Unix
    {
        private const int Here = -100; // paths are relative to the working folder
        private const uint Basic = 0x7ff; // what is asked: all that every file has
        private const int UserAt = 20, ModeAt = 28; // [bytes] in what statx tells, the same on all processors
        private const int OthersMay = 0x3f; // mode bits of the group and of all others

        /// <summary>The user's number; 0 where it cannot be told.</summary>
        public static uint User()
        {
            try
            {
                return geteuid();
            }
            catch (Exception error) when (Missing(error))
            {
                return 0;
            }
        }

        /// <summary>Why a file's secrets may be known to others, or may not be the server's; "" if all is well.</summary>
        public static string Danger(string path)
        {
            if (Environment.OSVersion.Platform == PlatformID.Win32NT || IsAndroid)
            {
                return "";
            }
            byte[] told = new byte[256];
            try
            {
                if (statx(Here, System.Text.Encoding.UTF8.GetBytes(path + "\0"), 0, Basic, told) != 0)
                {
                    return "";
                }
            }
            catch (Exception error) when (Missing(error))
            {
                return "";
            }
            if ((BitConverter.ToUInt16(told, ModeAt) & OthersMay) != 0)
            {
                return "others can read or change it, so its secrets are none: `chmod 600 " + path
                    + "`, then start the server again";
            }
            uint user = BitConverter.ToUInt32(told, UserAt);
            return user == User() || user == 0 ? "" : "belongs to another user, whose server it may be";
        }

        /// <summary>
        /// There a server runs on another machine; and the system keeps programs' files apart, but says of all that are in shared storage
        /// that their group may read them.
        /// </summary>
        public static bool IsAndroid
        {
            get { return System.IO.File.Exists("/system/build.prop"); }
        }

        private static bool Missing(Exception error)
        {
            return error is DllNotFoundException || error is EntryPointNotFoundException;
        }

        [DllImport("libc")]
        private static extern uint geteuid();

        [DllImport("libc")]
        private static extern int statx(int folder, byte[] path, int flags, uint mask, byte[] told);
    }
}
