using System;
using System.Runtime.InteropServices;

namespace Pacinian
{
    /// <summary>Reads users and file permissions on Linux; reports nothing on other systems.</summary>
    internal static class Unix
    {
        private const int Here = -100; // paths are relative to the working folder
        private const uint Basic = 0x7ff; // the requested fields, which every file has
        private const int UserAt = 20, ModeAt = 28; // [bytes] in the result of statx, the same on all processors
        private const int OthersMay = 0x3f; // mode bits of the group and of all others

        /// <summary>Returns the user's number; 0 if unknown.</summary>
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

        /// <summary>Returns why a file's secrets may be known to others, or may not be the server's; "" if the file is safe.</summary>
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
        /// Whether this is Android. There the server runs on another machine, and the system separates the files of
        /// programs, but it reports files in shared storage as readable by their group.
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
